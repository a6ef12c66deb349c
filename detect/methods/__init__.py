"""The published stiction methods, one a file."""
