"""All tags of one log together: which share an oscillation, and which loop's valve is the likely source."""

from stickslip.detect.plantwide.survey import Group, Survey, Suspect

__all__ = ["Group", "Survey", "Suspect"]
