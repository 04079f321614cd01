"""The model: an impact, by the equations of the paper, and the search for the ballistic limit."""
