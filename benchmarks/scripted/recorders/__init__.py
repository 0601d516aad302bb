"""Scripts that run among other people's environments and record what they do; they know nothing of ours."""
