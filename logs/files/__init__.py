"""Read the files that historians and control systems export, and write logs to files."""
