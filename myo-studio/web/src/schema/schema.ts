/** As much of JSON Schema as the schema of task files uses: fields with words, units, defaults and bounds. */
export interface Schema {
  $ref?: string;
  $defs?: Record<string, Schema>;
  type?: string | string[];
  description?: string;
  default?: unknown;
  const?: unknown;
  enum?: unknown[];
  minimum?: number;
  maximum?: number;
  exclusiveMinimum?: number;
  minItems?: number;
  maxItems?: number;
  items?: Schema;
  properties?: Record<string, Schema>;
  required?: string[];
  anyOf?: Schema[];
  oneOf?: Schema[];
  additionalProperties?: boolean | Schema;
  'x-unit'?: string;
}

/** What a field is edited as. */
export type Field =
  | { as: 'number'; whole: boolean; schema: Schema }
  | { as: 'range'; schema: Schema }
  | { as: 'place' }
  | { as: 'list'; length: number; of: Field; schema: Schema }
  | { as: 'choice'; of: string[] }
  | { as: 'switch' }
  | { as: 'text' }
  | { as: 'group'; schema: Schema }
  | { as: 'other' };

/** A schema, and what it refers to. */
export function resolve(schema: Schema, root: Schema): Schema {
  if (schema.$ref) {
    const name = schema.$ref.replace('#/$defs/', '');
    const { $ref: _, ...own } = schema;
    return { ...resolve(root.$defs?.[name] ?? {}, root), ...own };
  }
  const options = (schema.anyOf ?? []).filter((option) => option.type !== 'null');
  // What may be left out is what it is when it is there.
  if (schema.anyOf && options.length === 1 && schema.anyOf.length === 2) {
    const { anyOf: _, ...own } = schema;
    return { ...resolve(options[0], root), ...own };
  }
  return schema;
}

/** What a field is edited as. */
export function field(schema: Schema, root: Schema): Field {
  if (schema.$ref === '#/$defs/Place') return { as: 'place' };
  const whole = resolve(schema, root);
  const type = Array.isArray(whole.type) ? whole.type.find((type) => type !== 'null') : whole.type;
  if (whole.anyOf?.length === 2 && whole.anyOf[0].type === 'number' && whole.anyOf[1].type === 'array') {
    return { as: 'range', schema: { ...whole.anyOf[0] } };
  }
  const names = whole.enum ?? whole.oneOf?.map((option) => option.const);
  if (names?.every((name) => typeof name === 'string')) return { as: 'choice', of: names as string[] };
  if (type === 'number' || type === 'integer') return { as: 'number', whole: type === 'integer', schema: whole };
  if (type === 'boolean') return { as: 'switch' };
  if (type === 'string') return { as: 'text' };
  if (type === 'array' && whole.minItems !== undefined && whole.minItems === whole.maxItems && whole.items) {
    return { as: 'list', length: whole.minItems, of: field(whole.items, root), schema: whole };
  }
  if (type === 'object' && whole.properties) return { as: 'group', schema: whole };
  return { as: 'other' };
}

/** The fields of an item of a kind. */
export function fieldsOf(kind: string, root: Schema): Record<string, Schema> {
  const item = root.$defs?.Item;
  const own = item?.oneOf?.find((option) => option.properties?.kind?.const === kind);
  const { kind: _, ...fields } = own?.properties ?? {};
  return fields;
}

/** The least and greatest that a number may be, in words. */
export function bounds(schema: Schema): string {
  const unit = schema['x-unit'] ? ` ${schema['x-unit']}` : '';
  const least = schema.minimum ?? schema.exclusiveMinimum;
  if (least !== undefined && schema.maximum !== undefined) return `${least} to ${schema.maximum}${unit}`;
  if (least !== undefined) return `at least ${least}${unit}`;
  return unit.trim();
}
