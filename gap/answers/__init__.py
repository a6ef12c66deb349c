"""What a diagnosis answers with: the report, its picture, what it rests on and how sure it is."""
