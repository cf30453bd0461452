"""Cost beside each engine's own bare loop; run by ``make bench``, never part of the tests."""
