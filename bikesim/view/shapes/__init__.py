"""What is drawn, as triangles: the bicycle's parts, the rider, the land."""
