"""The lab: a page in the browser that drops balls in all engines, beside the real one."""
