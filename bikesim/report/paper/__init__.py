"""Schwab & Recuero 2013 [SR13] point by point, and what it could not show."""
