//! title: cocos2d-x: matrices, time and textures
//! uses: CC_MVPMatrix CC_PMatrix CC_MVMatrix CC_MultiViewPMatrix CC_NormalMatrix CC_Texture0 CC_Time CC_SinTime CC_Random01 CC_alpha_value
--- both
uniform mat4 CC_PMatrix;
uniform mat4 CC_MultiViewPMatrix[4];
uniform mat4 CC_MVMatrix;
uniform mat4 CC_MVPMatrix;
uniform mat3 CC_NormalMatrix;
uniform vec4 CC_Time;
uniform vec4 CC_SinTime;
uniform vec4 CC_CosTime;
uniform vec4 CC_Random01;
uniform sampler2D CC_Texture0;
uniform sampler2D CC_Texture1;
uniform sampler2D CC_Texture2;
uniform sampler2D CC_Texture3;
