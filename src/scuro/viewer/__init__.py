"""The viewer: one scene, its history, and any number of views of it, in whatever shows pixels.

``model`` holds the scene and what can be undone; ``view`` is one person's camera, picture and
panel; ``window`` , ``server`` and ``notebook`` bring a view to a screen.
"""
