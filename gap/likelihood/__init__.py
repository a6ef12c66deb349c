"""One likelihood of a log given a diagram: the diagram's own run is the filter's prediction."""
