"""Which one of the viewers may change something. Everybody may stop."""


class Control:
    """Held by at most one; free again when the holder is gone."""

    def __init__(self) -> None:
        self.holder: int | None = None

    def take(self, viewer: int) -> bool:
        """Whether the viewer holds it now."""
        if self.holder is None:
            self.holder = viewer
        return self.holder == viewer

    def release(self, viewer: int) -> None:
        if self.holder == viewer:
            self.holder = None
