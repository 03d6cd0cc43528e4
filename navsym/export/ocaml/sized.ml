(* Statements on matrices of any size at matrices of one size: the kind `sized` of docs/certificates.md, and the witness of `words`. *)

open Text
open Tree
open Goal

(* Texts *)

type term =
  | Number of Q.t
  | Ratio_of_circle (* pi *)
  | Name of string
  | Plus of term list
  | Minus of term
  | Times of term list
  | Below of term (* 1/x *)
  | Matmul of term * term
  | Power of term * term
  | Turned of term (* transposed *)
  | Call of string * term list

let rec grammar () =
  {
    sum = (fun l -> Plus l);
    negated = (fun t -> Minus t);
    product = (fun l -> Times l);
    below = (fun t -> Below t);
    applied = (fun a b -> Matmul (a, b));
    power = (fun a b -> Power (a, b));
    entry = read_entry;
  }

and read_entry r =
  let rec go t =
    match next r with
    | Mark "." ->
        drop r;
        if next r <> Tree.Name "T" then refuse "expression: expected .T";
        drop r;
        go (Turned t)
    | _ -> t
  in
  go (read_value r)

and read_value r =
  match next r with
  | Tree.Number q -> drop r; Number q
  | Mark "(" -> drop r; read_inside (grammar ()) r
  | Tree.Name "pi" -> drop r; Ratio_of_circle
  | Tree.Name name -> (
      drop r;
      match next r with
      | Mark "(" -> drop r; Call (name, read_arguments (grammar ()) r)
      | _ -> Name name)
  | _ -> refuse "expression: expected a number, a name or a parenthesis"

let read_whole r = read_sum (grammar ()) r

let read_text what value =
  let r = { rest = Language.read_tokens (get_text what value); depth = 0 } in
  let t = read_whole r in
  if next r <> End then refuse "%s: expected an operator" what;
  t

let read_equation value =
  let r = { rest = Language.read_tokens (get_text "given" value); depth = 0 } in
  let left = read_whole r in
  take r "=";
  let right = read_whole r in
  if next r <> End then refuse "given: expected an equation";
  (left, right)

(* Statements *)

type dimension = Any of string | Exactly of int
type matrix = { rows : dimension; columns : dimension; properties : string list }

type statement = {
  left : term;
  relation : string;
  right : term;
  box : (string * range) list;
  matrices : (string * matrix) list; (* in the order of the object *)
  dimensions : string list;
  given : (term * term) list;
}

let all_properties = [ "symmetric"; "positive"; "nonnegative"; "invertible"; "orthogonal"; "skew"; "diagonal" ]

let starts_with part s = String.length s >= String.length part && String.sub s 0 (String.length part) = part

let read_dimension known = function
  | Text s when List.mem s known -> Any s
  | Int z when Z.sign z > 0 && Z.leq z (Z.of_int 64) -> Exactly (Z.to_int z)
  | _ -> refuse "expected a dimension"

let read_matrix known (name, value) =
  match get_keys name [ "size"; "is" ] value with
  | [ size; properties ] ->
      let rows, columns =
        match get_list name size with
        | [ a; b ] -> (read_dimension known a, read_dimension known b)
        | _ -> refuse "%s: expected two dimensions" name
      in
      if rows = Exactly 1 && columns = Exactly 1 then refuse "%s: declare a number" name;
      let read_property v =
        let p = get_text name v in
        if not (List.mem p all_properties) then refuse "%s: an unknown property %s" name p;
        if rows <> columns then refuse "%s: a property of square matrices" name;
        p
      in
      (name, { rows; columns; properties = List.map read_property (get_list name properties) })
  | _ -> assert false

let read_statement value =
  match get_keys "statement" [ "left"; "relation"; "right"; "symbols"; "matrices"; "dimensions"; "given" ] value with
  | [ left; relation; right; symbols; matrices; dimensions; given ] ->
      let dimensions = List.map (get_name "dimensions") (get_list "dimensions" dimensions) in
      let matrices = List.map (read_matrix dimensions) (get_object "matrices" matrices) in
      let box = List.map (fun (name, v) -> (name, read_range name v)) (get_object "symbols" symbols) in
      let names = dimensions @ List.map fst matrices @ List.map fst box in
      if List.length (List.sort_uniq compare names) <> List.length names then refuse "a name given twice";
      let check name =
        if not (is_name name) then refuse "expected a name, got %S" name;
        if List.exists (fun p -> starts_with p name) [ "trace__"; "inv__"; "arg__" ] then refuse "%s: another name" name
      in
      List.iter check names;
      let relation = get_text "relation" relation in
      if not (List.mem relation Language.relation_marks) then refuse "unknown relation %S" relation;
      let left = read_text "left" left and right = read_text "right" right in
      { left; relation; right; box; matrices; dimensions; given = List.map read_equation (get_list "given" given) }
  | _ -> assert false

(* Values at a point *)

type value = Scalar of tree | Rectangle of dimension * dimension * Q.t list list

type point = { sizes : (string * int) list; entries : (string * Q.t list list) list; numbers : (string * tree) list }

let size_at point = function Any s -> List.assoc s point.sizes | Exactly n -> n

(* A number as it is typed has a value, and that is rational. *)
let rational point t =
  let ball s = match List.assoc_opt s point.numbers with Some x -> Value.number_ball s x | None -> Value.no_symbols s in
  if Value.finite_ball ball t = None then refuse "the statement may have no value there";
  match !constant (put point.numbers t) with Some q -> q | None -> refuse "a number that is not rational"

let transpose = function [] -> [] | first :: _ as m -> List.mapi (fun j _ -> List.map (fun row -> List.nth row j) m) first
let dot u v = List.fold_left2 (fun s a b -> Q.add s (Q.mul a b)) Q.zero u v
let product a b = let columns = transpose b in List.map (fun row -> List.map (dot row) columns) a
let unit_matrix n = List.init n (fun i -> List.init n (fun j -> if i = j then Q.one else Q.zero))

(* The first row that has an entry in the first column is brought to the top: each row that it passes changes the sign. *)
let rec determinant = function
  | [] -> Q.one
  | m -> (
      let rec pick before = function
        | row :: l when Q.sign (List.hd row) <> 0 -> Some (List.length before, row, List.rev_append before l)
        | row :: l -> pick (row :: before) l
        | [] -> None
      in
      match pick [] m with
      | None -> Q.zero
      | Some (passed, pivot, others) ->
          let top = List.hd pivot in
          let reduce row =
            let c = Q.div (List.hd row) top in
            List.map2 (fun x p -> Q.sub x (Q.mul c p)) (List.tl row) (List.tl pivot)
          in
          let d = Q.mul top (determinant (List.map reduce others)) in
          if passed land 1 = 1 then Q.neg d else d)

let inverse m =
  let n = List.length m in
  let d = determinant m in
  if Q.sign d = 0 then refuse "an inverse that does not exist: the statement may have no value there";
  let minor i j = List.filteri (fun k _ -> k <> i) m |> List.map (List.filteri (fun k _ -> k <> j)) in
  let entry i j = let c = Q.div (determinant (minor j i)) d in if (i + j) land 1 = 1 then Q.neg c else c in
  List.init n (fun i -> List.init n (entry i))

let rec evaluate s point t =
  let go = evaluate s point in
  let scalar what t = match go t with Scalar x -> x | Rectangle _ -> refuse "%s: expected a number" what in
  let scaled x = function
    | Scalar y -> Scalar (Prod [ x; y ])
    | Rectangle (a, b, m) -> let q = rational point x in Rectangle (a, b, List.map (List.map (Q.mul q)) m)
  in
  match t with
  | Number q -> Scalar (Num q)
  | Ratio_of_circle -> Scalar Pi
  | Name name -> (
      match (List.assoc_opt name s.matrices, List.assoc_opt name point.sizes) with
      | Some m, _ -> Rectangle (m.rows, m.columns, List.assoc name point.entries)
      | None, Some n -> Scalar (Tree.number n)
      | None, None -> if List.mem_assoc name s.box then Scalar (Sym name) else Value.no_symbols name)
  | Plus l -> add (List.map go l)
  | Minus t -> ( match go t with Scalar x -> Scalar (negate x) | m -> scaled (Num Q.minus_one) m)
  | Below t -> Scalar (Pow (scalar "a divisor" t, Num Q.minus_one))
  | Times l -> (
      let is_matrix = function Rectangle _ -> true | Scalar _ -> false in
      let matrices, numbers = List.partition is_matrix (List.map go l) in
      let x = Prod (one :: List.map (function Scalar x -> x | Rectangle _ -> assert false) numbers) in
      match matrices with [] -> Scalar x | [ m ] -> scaled x m | _ -> refuse "products of matrices are written with @")
  | Matmul (a, b) -> multiply (go a) (go b)
  | Power (a, b) -> let x = scalar "a base" a in Scalar (Pow (x, scalar "an exponent" b))
  | Turned t -> turn (go t)
  | Call ("transpose", [ t ]) -> turn (go t)
  | Call ("inv", [ t ]) -> (
      match go t with
      | Rectangle (a, b, m) when a = b -> Rectangle (a, b, inverse m)
      | _ -> refuse "inv: expected a square matrix")
  | Call ("trace", [ t ]) -> (
      match go t with
      | Rectangle (a, b, m) when a = b ->
          Scalar (Num (List.fold_left Q.add Q.zero (List.mapi (fun i row -> List.nth row i) m)))
      | _ -> refuse "trace: expected a square matrix")
  | Call ("dot", [ u; v ]) -> multiply (turn (go u)) (go v)
  | Call ("eye", [ n ]) -> let d = dimension_of s n in let k = size_at point d in Rectangle (d, d, unit_matrix k)
  | Call ("zeros", [ m; n ]) ->
      let a = dimension_of s m and b = dimension_of s n in
      Rectangle (a, b, List.init (size_at point a) (fun _ -> List.init (size_at point b) (fun _ -> Q.zero)))
  | Call (name, [ t ]) when List.mem name of_one -> Scalar (apply name (scalar name t))
  | Call (name, _) -> refuse "expression: unknown function %s" name

and dimension_of s = function
  | Name n when List.mem n s.dimensions -> Any n
  | Number q when is_whole q && Q.sign q > 0 && Q.leq q (Q.of_int 64) -> Exactly (Z.to_int q.Q.num)
  | _ -> refuse "expected a dimension"

and turn = function Rectangle (a, b, m) -> Rectangle (b, a, transpose m) | Scalar _ -> refuse ".T: expected a matrix"

and multiply a b =
  match (a, b) with
  | Rectangle (p, q, m), Rectangle (r, s, n) ->
      if q <> r then refuse "@: different sizes";
      let c = product m n in
      if p = Exactly 1 && s = Exactly 1 then Scalar (Num (List.hd (List.hd c))) else Rectangle (p, s, c)
  | _ -> refuse "@: expected matrices"

and add = function
  | [] -> assert false
  | Scalar _ :: _ as l -> Scalar (Sum (List.map (function Scalar x -> x | Rectangle _ -> refuse "a number and a matrix") l))
  | first :: rest ->
      let plus a b =
        match (a, b) with
        | Rectangle (p, q, m), Rectangle (r, s, n) when p = r && q = s -> Rectangle (p, q, List.map2 (List.map2 Q.add) m n)
        | _ -> refuse "different sizes"
      in
      List.fold_left plus first rest

(* Both sides as lists of rational numbers, and whether they are numbers *)
let sides s point (left, right) =
  match (evaluate s point left, evaluate s point right) with
  | Scalar a, Scalar b -> (true, [ rational point a ], [ rational point b ])
  | Rectangle (p, q, m), Rectangle (r, s, n) when p = r && q = s -> (false, List.concat m, List.concat n)
  | _ -> refuse "sides of different sizes"

let holds_at s point =
  let are_numbers, left, right = sides s point (s.left, s.right) in
  let equal = List.for_all2 Q.equal left right in
  if (not are_numbers) && not (List.mem s.relation [ "="; "!=" ]) then refuse "matrices have no order";
  let a = List.hd left and b = List.hd right in
  match s.relation with
  | "=" -> equal
  | "!=" -> not equal
  | ">" -> Q.gt a b
  | ">=" -> Q.geq a b
  | "<" -> Q.lt a b
  | _ -> Q.leq a b

(* Properties by exact minors *)

let has_property m name =
  let n = List.length m in
  let equal a b = List.for_all2 (List.for_all2 Q.equal) a b in
  let symmetric () = equal m (transpose m) in
  let chosen keep = List.filteri (fun i _ -> keep i) m |> List.map (List.filteri (fun j _ -> keep j)) in
  match name with
  | "symmetric" -> symmetric ()
  | "positive" -> symmetric () && List.for_all (fun k -> Q.sign (determinant (chosen (fun i -> i <= k))) > 0) (List.init n Fun.id)
  | "nonnegative" ->
      let is_least mask = Q.sign (determinant (chosen (fun i -> mask land (1 lsl i) <> 0))) >= 0 in
      symmetric () && List.for_all is_least (List.init (1 lsl n) Fun.id)
  | "invertible" -> Q.sign (determinant m) <> 0
  | "orthogonal" -> equal (product (transpose m) m) (unit_matrix n)
  | "skew" -> equal m (List.map (List.map Q.neg) (transpose m))
  | _ -> List.for_all Fun.id (List.concat (List.mapi (fun i row -> List.mapi (fun j x -> i = j || Q.sign x = 0) row) m))

let read_point s value =
  match get_keys "point" [ "sizes"; "matrices"; "numbers" ] value with
  | [ sizes; matrices; numbers ] ->
      let same what names found =
        if List.sort compare names <> List.sort compare (List.map fst found) then refuse "%s: expected every name and no other" what
      in
      let sizes = List.map (fun (n, v) -> (n, get_integer "sizes" 1 8 v)) (get_object "sizes" sizes) in
      same "sizes" s.dimensions sizes;
      let numbers = read_numbers "numbers" numbers in
      check_point s.box numbers;
      let read (name, rows) =
        let m = match List.assoc_opt name s.matrices with Some m -> m | None -> refuse "matrices: unknown name %s" name in
        let at = function Any d -> List.assoc d sizes | Exactly n -> n in
        let rows = List.map (fun row -> List.map (get_number name) (get_list name row)) (get_list name rows) in
        let width = at m.columns in
        if List.length rows <> at m.rows || List.exists (fun row -> List.length row <> width) rows then
          refuse "%s: expected %d rows of %d entries" name (at m.rows) width;
        if m.rows = m.columns && List.length rows > 8 && m.properties <> [] then outside "properties of large matrices";
        if not (List.for_all (has_property rows) m.properties) then refuse "%s: a matrix without its properties" name;
        (name, rows)
      in
      let entries = List.map read (get_object "matrices" matrices) in
      same "matrices" (List.map fst s.matrices) entries;
      { sizes; entries; numbers }
  | _ -> assert false

(* All hypotheses hold at the point. *)
let check_hypotheses s point =
  let holds equation = let _, a, b = sides s point equation in List.for_all2 Q.equal a b in
  shown "a hypothesis does not hold at the point" (List.for_all holds s.given)

let check value =
  match get_keys "sized" [ "kind"; "statement"; "point" ] value with
  | [ _; statement; point ] ->
      let s = read_statement statement in
      let point = read_point s point in
      check_hypotheses s point;
      shown "the statement holds there" (not (holds_at s point))
  | _ -> assert false
