"""`make bench`: what manyhands does in a second, beside the programs people use today, measured in the same run."""
