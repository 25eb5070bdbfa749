"""The scene that a pose of the bicycle is shown in, and the pictures and videos made of it."""
