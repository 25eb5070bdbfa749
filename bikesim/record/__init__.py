"""The record: one HDF5 file a run, written while it runs, and what is made from it."""
