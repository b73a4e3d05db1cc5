#include <GL/glew.h>
#include <cstring>
#include <vector>
#include "gg.h"

// 頭髪の描画：毛髪ごとに隣接頂点つきの折れ線を一本ずつ描く
// Draws n strands of m nodes each. A strip with adjacency has its first and its last node only as
// neighbours, so both ends of a strand are stored twice: m + 2 nodes give all m - 1 segments.

void drawHair(const GLfloat (*strands)[4], const GLfloat *mvp, GLsizei n, GLsizei m)
{
  GLuint program = ggLoadShader("hair.vert", "hair.frag", "hair.geom");
  GLint mcLoc = glGetUniformLocation(program, "mc");

  // 両端の節点を二重にした毛髪
  struct Node { GLfloat position[4]; };
  std::vector<Node> nodes(static_cast<size_t>(n) * (m + 2));
  std::vector<GLint> first(n);
  std::vector<GLsizei> count(n);
  for (GLsizei i = 0; i < n; ++i)
  {
    first[i] = i * (m + 2);
    count[i] = m + 2;

    for (GLsizei k = 0; k < m + 2; ++k)
    {
      // 前後に一つずつはみ出した番号は端の節点に寄せる
      GLsizei j = k == 0 ? 0 : k > m ? m - 1 : k - 1;
      std::memcpy(nodes[first[i] + k].position, strands[i * m + j], sizeof (GLfloat[4]));
    }
  }

  GLuint buffer;
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, sizeof (Node) * nodes.size(), nodes.data(), GL_STATIC_DRAW);
  glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 0, 0);
  glEnableVertexAttribArray(0);

  glUseProgram(program);
  glUniformMatrix4fv(mcLoc, 1, GL_FALSE, mvp);
  glMultiDrawArrays(GL_LINE_STRIP_ADJACENCY, first.data(), count.data(), n);
}
