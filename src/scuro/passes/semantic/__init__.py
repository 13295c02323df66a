"""Semantic occlusion: the hierarchy decides what may darken what (Koch 2018)."""
