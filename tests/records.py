"""Runs that differ from others in what their record says."""

from dataclasses import replace


def changed(run, **fields):
    """The same run with fields of its record replaced."""
    return replace(run, record=replace(run.record, **fields))


def with_sources(run, **fields):
    """The same run with fields of every source replaced; each is a list, one for each source."""
    rows = zip(*fields.values(), strict=True)
    return changed(
        run,
        sources=tuple(
            replace(source, **dict(zip(fields, row, strict=True)))
            for source, row in zip(run.record.sources, rows, strict=True)
        ),
    )


def with_source(run, number, **fields):
    """The same run with fields of one source replaced."""
    sources = list(run.record.sources)
    sources[number] = replace(sources[number], **fields)
    return changed(run, sources=tuple(sources))
