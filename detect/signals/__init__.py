"""What any signal is asked, whatever it means: smoothed, filtered, ordered, cut at gaps, crossed, drawn anew."""
