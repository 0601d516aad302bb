"""Scripts that run among other people's environments and write the scenes they compose; they know nothing of ours."""
