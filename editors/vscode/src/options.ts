// What the language server is started with, out of the settings.

/** Settings of the section `shadercheck`. */
export interface Settings {
  get<T>(name: string, otherwise: T): T;
}

/** `initializationOptions`; what is not stated is left out, and the server, or shadercheck.toml, decides. */
export function serverOptions(settings: Settings): Record<string, unknown> {
  const options: Record<string, unknown> = {};
  const lang = settings.get<string>("lang", "auto");
  if (lang !== "auto") options.lang = lang;
  const level = settings.get<string>("level", "auto");
  if (level !== "auto") options.level = level;
  const select = settings.get<string[]>("select", []);
  if (select.length > 0) options.select = select;
  const ignore = settings.get<string[]>("ignore", []);
  if (ignore.length > 0) options.ignore = ignore;
  const pages = settings.get<string>("rulePages", "");
  if (pages) options.rulePages = pages;
  const conversions = settings.get<boolean>("hints.conversions", true);
  options.hints = { conversions, offsets: settings.get<boolean>("hints.offsets", true) };
  return options;
}
