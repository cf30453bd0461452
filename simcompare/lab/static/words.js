// the texts of the page, in its language
const texts = JSON.parse(document.getElementById("texts").textContent);

export const language = document.documentElement.lang;

/** A text such as words("real.heard", {count: 3}); what stands in {braces} is filled in. */
export function words(key, values = {}) {
  const found = key.split(".").reduce((part, name) => part && part[name], texts) ?? key;
  return found.replace(/\{(\w+)\}/g, (whole, name) => values[name] ?? whole);
}

/** The name of a parameter in words; its unit stands beside the number. */
export function quantity(name, unit = "") {
  const ending = `_${unit.replace(/²/g, "2").replace(/³/g, "3").replace("Ω", "Ohm").replace(/[/·*^]/g, "_")}`;
  const stem = unit && name.endsWith(ending) ? name.slice(0, -ending.length) : name.replace(/_(m|kg|s|rad|m_s2|kg_m3|n_m|hz|deg)$/, "");
  return texts.quantities[stem] ?? stem.replaceAll("_", " ");
}
