"""The open benchmark of the gap diagnosis: records whose hidden effect is known, made by a program of its own."""
