"""What the verdict is worth where sticking is crossed with all else, on families that are held back from learning."""
