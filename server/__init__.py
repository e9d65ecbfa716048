"""The HTTP and WebSocket server around a live session; imports `robot`, never the other way."""

if __name__ != "slidetune.server":  # else every module would be there twice
    raise ImportError("import slidetune.server: server is its folder, not its name", name=__name__)
