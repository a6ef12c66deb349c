"""What detection costs and how well it does."""
