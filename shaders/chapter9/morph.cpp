#include <GL/glew.h>
#include "gg.h"

// モーフィング：変形後の形状の頂点を attribute 変数 p1 に割り当てる
// Adds the second shape to the first one and draws the edges in between.

void drawMorph(const GLfloat (*target)[3], GLsizei vertices, GLsizei lines)
{
  GLuint program = ggLoadShader("morph.vert", "morph.frag");

  // 変形後の頂点のバッファ
  GLuint buffer;
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, sizeof (GLfloat[3]) * vertices, target, GL_STATIC_DRAW);

  // 変数 p1 の場所、見つからなければ -1
  GLint p1Loc = glGetAttribLocation(program, "p1");

  glUseProgram(program);
  glVertexAttribPointer(p1Loc, 3, GL_FLOAT, GL_FALSE, 0, 0);
  glEnableVertexAttribArray(p1Loc);
  glDrawElements(GL_LINES, lines, GL_UNSIGNED_INT, 0);
}
