"""The live display: a window on a ride that goes on in another process."""
