"""JSON Schema of scenario files, for editors.

``python -m simcompare.scenarios.schema`` writes it anew.
"""

from __future__ import annotations

import json
from typing import Any

from simcompare.model.fittable import Fittable
from simcompare.model.plain import Plain
from simcompare.model.scenario import Scenario
from simcompare.model.tabled import Tabled
from simcompare.model.uncertain import Uncertain
from simcompare.scenarios.scenario_file import SCHEMA_PATH, Parameter, Preset

_EXPRESSION = {"type": "string", "pattern": r"^\s*\$\{.*\}\s*$"}


def build() -> Plain:
    """Schema of a scenario file: the scenario, its parameters and presets, and expressions."""
    schema = Scenario.model_json_schema()
    definitions = schema["$defs"]
    definitions["Parameter"] = Parameter.model_json_schema()
    definitions["Preset"] = Preset.model_json_schema()
    fittable = Fittable.model_json_schema()
    definitions.update(fittable.pop("$defs"))
    definitions["Fittable"] = fittable
    uncertain = Uncertain.model_json_schema()
    definitions.update(uncertain.pop("$defs"))
    definitions["Uncertain"] = uncertain
    tabled = Tabled.model_json_schema()
    definitions.update(tabled.pop("$defs"))
    definitions["Tabled"] = tabled
    schema["properties"]["parameters"] = _mapping_of("Parameter")
    schema["properties"]["presets"] = _mapping_of("Preset")
    schema["properties"]["fit"] = {"$ref": "#/$defs/Fittable"}
    schema["properties"]["uncertainty"] = {"$ref": "#/$defs/Uncertain"}
    schema["properties"]["table"] = {"$ref": "#/$defs/Tabled"}
    schema["properties"]["extends"] = {"type": "string"}
    schema["title"] = "simcompare scenario"
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    for part in [*(definitions[name] for name in definitions if name not in _PLAIN), schema]:
        part["properties"] = {k: _or_expression(v) for k, v in part.get("properties", {}).items()}
        if isinstance(part.get("additionalProperties"), dict):
            part["additionalProperties"] = _or_expression(part["additionalProperties"])
    whole = {
        key: schema.pop(key) for key in ("properties", "required", "additionalProperties", "type")
    }
    # a variant says only what differs: parts of parts, and null for what it takes away
    own = {key: whole["properties"][key] for key in ("name", "title", "question")}
    variant = {"properties": own, "required": list(own)}
    return {**schema, "if": {"required": ["extends"]}, "then": variant, "else": whole}


_PLAIN = (
    "Parameter", "Preset", "Fittable", "Grid", "Uncertain", "KnownBy", "Tabled", "TabledColumn",
    "Assumed",
)  # fmt: skip


def _mapping_of(name: str) -> Plain:
    return {"type": "object", "additionalProperties": {"$ref": f"#/$defs/{name}"}}


def _or_expression(node: Any) -> Any:  # noqa: ANN401
    """The same schema, but every number may also be written as ``${…}``."""
    if isinstance(node, list):
        return [_or_expression(item) for item in node]
    if not isinstance(node, dict):
        return node
    if node.get("type") in ("number", "integer"):
        return {"anyOf": [node, _EXPRESSION]}
    return {key: _or_expression(value) for key, value in node.items()}


def main() -> None:
    """Writes ``scenario.schema.json`` beside this file."""
    SCHEMA_PATH.write_text(json.dumps(build(), indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
