"""Statistics and the page of an experiment of many runs."""
