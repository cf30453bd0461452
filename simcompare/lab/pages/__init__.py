"""Pages of the lab, as jinja2 fills them."""
