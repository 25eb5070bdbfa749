"""bikesim: a haptic bicycle simulator, virtual or on a bench (Schwab & Recuero 2013)."""

__version__ = "0.1.0"
