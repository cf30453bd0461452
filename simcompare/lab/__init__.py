"""The lab: a web page on which students drop a ball and see every engine beside it."""
