"""From fitted hypotheses to what is said: which effects, with what confidence, and why not another."""
