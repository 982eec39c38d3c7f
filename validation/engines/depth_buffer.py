# SPDX-License-Identifier: GPL-3.0-or-later
"""A renderer with a depth buffer: OpenGL without a window (EGL; Mesa's rasteriser where there is no graphics card).

What the two engines of depth_pictures.py have in common. A view is a camera that looks along the middle of its part of
the fan; a column of its picture is a beam, and holds one column of samples: range, and cos(incidence) x strength or other.
"""
import contextlib
import os

import numpy as np

# PyOpenGL and Mesa read these when they are loaded. Without a graphics card: the same picture everywhere.
for name, value in (("PYOPENGL_PLATFORM", "egl"), ("EGL_PLATFORM", "surfaceless"), ("LIBGL_ALWAYS_SOFTWARE", "1")):
    os.environ.setdefault(name, value)

VERTEX = """#version 330
layout(location = 0) in vec3 place; layout(location = 1) in vec4 normal_strength;
uniform mat4 projection; uniform mat3 turned; uniform vec3 eye;
out vec3 from_eye; flat out vec4 surface;
void main() {
  from_eye = place - eye; surface = normal_strength;
  gl_Position = projection * vec4(turned * from_eye, 1.0);
}"""
FRAGMENT = """#version 330
in vec3 from_eye; flat in vec4 surface;
layout(location = 0) out vec4 sample_of;
void main() {
  float range = length(from_eye);
  sample_of = vec4(range, abs(dot(surface.xyz, from_eye)) / range, surface.w, 1.0);
}"""


@contextlib.contextmanager
def offscreen():
    """A current OpenGL context without window and without screen."""
    from OpenGL import EGL
    display = EGL.eglGetDisplay(EGL.EGL_DEFAULT_DISPLAY)
    if not EGL.eglInitialize(display, EGL.EGLint(), EGL.EGLint()):
        raise RuntimeError("EGL has no display")
    try:
        wanted = (EGL.EGLint * 5)(EGL.EGL_SURFACE_TYPE, EGL.EGL_PBUFFER_BIT, EGL.EGL_RENDERABLE_TYPE, EGL.EGL_OPENGL_BIT,
                                  EGL.EGL_NONE)
        configuration, number = (EGL.EGLConfig * 1)(), EGL.EGLint()
        EGL.eglChooseConfig(display, wanted, configuration, 1, number)
        EGL.eglBindAPI(EGL.EGL_OPENGL_API)
        context = EGL.eglCreateContext(display, configuration[0], EGL.EGL_NO_CONTEXT, None)
        EGL.eglMakeCurrent(display, EGL.EGL_NO_SURFACE, EGL.EGL_NO_SURFACE, context)
        yield
    finally:
        EGL.eglTerminate(display)


def perspective(half_width, half_height, near, far):
    """Of half angles."""
    matrix = np.zeros((4, 4))
    matrix[0, 0], matrix[1, 1] = 1 / np.tan(half_width), 1 / np.tan(half_height)
    matrix[2, 2], matrix[2, 3], matrix[3, 2] = -(far + near) / (far - near), -2 * far * near / (far - near), -1
    return matrix


def views_of(sonar, views):
    """Middle azimuth and half width of each view."""
    half = sonar.half_fan / views
    return [(-sonar.half_fan + (2 * k + 1) * half, half) for k in range(views)]


def column_azimuths(sonar, views):
    """Where the columns really look, which are even in the tangent."""
    columns = sonar.beams // views
    place = (np.arange(columns) + 0.5) / columns * 2 - 1
    return np.concatenate([middle + np.arctan(place * np.tan(half)) for middle, half in views_of(sonar, views)])


def samples(scene, sonar, views, rows):
    """(beams, rows, 3): range, cosine and strength of each sample, range infinite where nothing is."""
    if sonar.beams % views:
        raise ValueError(f"{sonar.beams} beams cannot be shared out to {views} views")
    from OpenGL import GL
    from OpenGL.GL import shaders
    columns = sonar.beams // views
    with offscreen():
        program = shaders.compileProgram(shaders.compileShader(VERTEX, GL.GL_VERTEX_SHADER),
                                         shaders.compileShader(FRAGMENT, GL.GL_FRAGMENT_SHADER))
        corners = np.empty((len(scene.triangles), 3, 7), np.float32)
        corners[:, :, :3] = scene.triangles
        corners[:, :, 3:6], corners[:, :, 6] = scene.normal[:, None], scene.mu[:, None]
        GL.glBindVertexArray(GL.glGenVertexArrays(1))
        GL.glBindBuffer(GL.GL_ARRAY_BUFFER, GL.glGenBuffers(1))
        GL.glBufferData(GL.GL_ARRAY_BUFFER, corners.nbytes, corners, GL.GL_STATIC_DRAW)
        for index, (length, offset) in enumerate(((3, 0), (4, 12))):
            GL.glEnableVertexAttribArray(index)
            GL.glVertexAttribPointer(index, length, GL.GL_FLOAT, False, 28, GL.ctypes.c_void_p(offset))
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, GL.glGenFramebuffers(1))
        for kind, attachment in ((GL.GL_RGBA32F, GL.GL_COLOR_ATTACHMENT0), (GL.GL_DEPTH_COMPONENT32F, GL.GL_DEPTH_ATTACHMENT)):
            buffer = GL.glGenRenderbuffers(1)
            GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, buffer)
            GL.glRenderbufferStorage(GL.GL_RENDERBUFFER, kind, columns, rows)
            GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, attachment, GL.GL_RENDERBUFFER, buffer)
        if GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER) != GL.GL_FRAMEBUFFER_COMPLETE:
            raise RuntimeError("OpenGL has no buffers of floats")
        GL.glViewport(0, 0, columns, rows)
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glUseProgram(program)
        place_of = lambda name: GL.glGetUniformLocation(program, name)
        GL.glUniform3f(place_of("eye"), *sonar.apex)
        result = []
        for middle, half in views_of(sonar, views):
            # What is nearer than the picture is cut away: the near plane stands at its first range.
            projection = perspective(half, sonar.height / 2, sonar.edges[0], 1.2 * sonar.edges[-1])
            right = sonar.directions(middle + np.pi / 2, 0.0)
            ahead = sonar.directions(middle, 0.0)
            turned = np.stack([right, sonar.axes[:, 2], -ahead])
            GL.glUniformMatrix4fv(place_of("projection"), 1, True, projection.astype(np.float32))
            GL.glUniformMatrix3fv(place_of("turned"), 1, True, turned.astype(np.float32))
            GL.glClearColor(np.inf, 0, 0, 0)
            GL.glClear(GL.GL_COLOR_BUFFER_BIT | GL.GL_DEPTH_BUFFER_BIT)
            GL.glDrawArrays(GL.GL_TRIANGLES, 0, 3 * len(scene.triangles))
            pixels = GL.glReadPixels(0, 0, columns, rows, GL.GL_RGBA, GL.GL_FLOAT)
            result.append(np.asarray(pixels, float).reshape(rows, columns, 4)[:, :, :3].transpose(1, 0, 2))
        return np.concatenate(result)
