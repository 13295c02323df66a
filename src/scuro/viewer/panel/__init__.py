"""The panel beside the picture, made from the settings' own definitions."""

from scuro.viewer.panel.panel import WIDTH, Panel

__all__ = ["WIDTH", "Panel"]
