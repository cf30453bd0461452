"""What sensors that are not ideal read: words, tables and figures."""
