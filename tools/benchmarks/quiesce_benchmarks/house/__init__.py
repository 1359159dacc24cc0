"""Figures about the project itself: its pages, its folders, its waiting times."""
