//! title: GameMaker: matrices, lights and the base texture
//! uses: gm_Matrices gm_BaseTexture gm_AmbientColour gm_LightingEnabled
--- both
#define MATRIX_VIEW 0
#define MATRIX_PROJECTION 1
#define MATRIX_WORLD 2
#define MATRIX_WORLD_VIEW 3
#define MATRIX_WORLD_VIEW_PROJECTION 4
uniform mat4 gm_Matrices[5];
uniform sampler2D gm_BaseTexture;
--- vertex
#define MAX_VS_LIGHTS 8
uniform bool gm_LightingEnabled;
uniform vec4 gm_Lights_Direction[8];
uniform vec4 gm_Lights_PosRange[8];
uniform vec4 gm_Lights_Colour[8];
uniform vec4 gm_AmbientColour;
uniform bool gm_VS_FogEnabled;
uniform float gm_FogStart;
uniform float gm_RcpFogRange;
--- fragment
uniform bool gm_PS_FogEnabled;
uniform vec4 gm_FogColour;
uniform bool gm_AlphaTestEnabled;
uniform float gm_AlphaRefValue;
