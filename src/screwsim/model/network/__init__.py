"""A machine as cells and connections, and the text of the functions that follow from them."""
