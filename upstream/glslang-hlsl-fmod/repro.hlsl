float4 main(float2 p : P) : SV_Target { return fmod(p.x, p.y); }
