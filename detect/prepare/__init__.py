"""What methods share: facts about a record, filters, half cycles."""
