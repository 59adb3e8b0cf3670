"""What a user did wrong, said in one line."""

__all__ = ["InputError"]


class InputError(ValueError):
    """Bad input or usage: the message says what is wrong, where, and what to do.

    The command line prints it as one line on stderr and exits with 2.
    """
