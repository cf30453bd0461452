"""What the tests of single checks share: a stream under repair, made of a few arrays."""

import numpy as np

from simcompare.hardware.conditioning.units import naming
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.mapping import of_tree
from simcompare.hardware.raw import RawColumn, RawStream


def work_of(time_s, columns, mapping=None, *, assume_units=False):
    """A stream whose clock is in order already.

    Args:
        time_s: times of the samples.
        columns: name -> (values, unit).
        mapping: a mapping file as a tree.
        assume_units: as the command line's option.
    """
    time_s = np.array(time_s, dtype=float)
    made = [RawColumn("t", time_s.copy(), "s")]
    made += [RawColumn(name, np.array(v, dtype=float), unit) for name, (v, unit) in columns.items()]
    stream = RawStream("log", made, time="t")
    work = Work(stream, of_tree(mapping or {}, "map"), assume_units)
    naming.prepare(work)
    work.time_s = time_s
    return work
