//! title: Qt: on the desktop, words of precision stand for nothing
//! version-below: 130
//! project: QOpenGLShader
//! says: highp mediump lowp
--- both
#define lowp
#define mediump
#define highp
