"""Pages of HTML that open offline."""
