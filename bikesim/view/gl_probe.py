"""Tries the OpenGL that the environment asks for; prints what it is as one line of JSON.

A process of its own, because MuJoCo chooses its OpenGL once, when it is imported, and because a
broken driver may take the process with it.
"""

import json
import sys


def main() -> int:
    """Exit status 1 with the reason on stdout where there is none."""
    try:
        from mujoco.rendering.classic.gl_context import GLContext

        context = GLContext(64, 64)
        context.make_current()
        from OpenGL import GL

        renderer = GL.glGetString(GL.GL_RENDERER)
        if renderer is None:
            raise RuntimeError("it has no renderer")
        sizes = [int(GL.glGetIntegerv(GL.GL_MAX_RENDERBUFFER_SIZE))]
        sizes += [int(size) for size in GL.glGetIntegerv(GL.GL_MAX_VIEWPORT_DIMS)]
        found = {"renderer": renderer.decode(errors="replace"), "largest": min(sizes)}
        context.free()
    except Exception as error:  # whatever a driver may come up with
        print(json.dumps({"error": " ".join(str(error).split())}))
        return 1
    print(json.dumps(found), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
